"""The data catalogue: public friction records, where they come from, and their tidy tables."""

from stickslip.catalogue.cache_paths import Place, cache_folder
from stickslip.catalogue.dataset import Dataset
from stickslip.catalogue.registry import dataset, names
from stickslip.catalogue.schema import Column, DataFile

__all__ = ["Column", "DataFile", "Dataset", "Place", "cache_folder", "dataset", "names"]
