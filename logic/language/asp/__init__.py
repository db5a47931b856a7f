"""What the ``.lp`` files of a grammar state, and what is wrong in them."""
