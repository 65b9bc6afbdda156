"""PDFs at true scale, by ReportLab, which nothing else imports."""
