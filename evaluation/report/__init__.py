"""Reports of the studies: report.md, report.html and figures, made from their CSV files."""
