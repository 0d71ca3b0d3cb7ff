"""`eha open`: a page on this machine that leads from a log file to a diagnosis; needs starlette and uvicorn."""
