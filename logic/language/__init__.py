"""The rule language: rule files are read, judged, and made ready for both stages."""
