"""A run as one HTML file that needs nothing else: see ``agent.report.page``."""
