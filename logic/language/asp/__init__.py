"""Contents of the ``.lp`` files of a grammar, and the mistakes in them."""
