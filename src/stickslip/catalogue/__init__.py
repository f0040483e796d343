"""The data catalogue: public friction records, where they come from, and their tidy tables."""

from stickslip.catalogue.cache_paths import CacheLocation, cache_folder
from stickslip.catalogue.dataset import Dataset
from stickslip.catalogue.registry import dataset, names
from stickslip.catalogue.schema import Column, DataFile

__all__ = ["CacheLocation", "Column", "DataFile", "Dataset", "cache_folder", "dataset", "names"]
