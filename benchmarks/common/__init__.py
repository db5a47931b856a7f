"""Code that several studies share: series and fitted laws, plots, pages, processes, houses."""
