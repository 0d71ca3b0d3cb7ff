"""Message and service types: their definitions, Python classes and CDR codecs."""
