"""Where tasks of flights run: processes here, or a cluster by Dask, which nothing else imports."""
