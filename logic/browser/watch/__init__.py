"""``vitruvius watch``: a page on this machine that draws what a grammar makes whenever a rule file is saved.

``session.py`` knows the rules as they are now and asks the processes of ``pool.py``; ``server.py`` hands its
answers to the page, whose files are in ``page/``: ``page.js`` says what it asks of them.
"""
