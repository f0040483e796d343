"""The data catalogue: public friction records, where they come from, and their tidy tables."""

from stickslip.catalogue.cache import CacheLocation, cache_folder
from stickslip.catalogue.dataset import Column, DataFile, Dataset, dataset, names

__all__ = ["CacheLocation", "Column", "DataFile", "Dataset", "cache_folder", "dataset", "names"]
