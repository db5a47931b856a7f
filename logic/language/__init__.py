"""The rule language: readers and checks of rule files, and their preparation for both stages."""
