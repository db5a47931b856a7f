"""Plans of houses, as SVG, PNG and PDF."""
