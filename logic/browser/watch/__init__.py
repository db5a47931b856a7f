"""``vitruvius watch``: a local page that draws the houses of a grammar whenever a rule file is saved.

``session.py`` holds the current rules and asks the processes of ``pool.py``. ``server.py`` passes the answers
to the page, whose files are in ``page/``; ``page.js`` lists the answers that the page expects.
"""
