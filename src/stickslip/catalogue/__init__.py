"""The data catalogue: public friction records, where they come from, and their tidy tables."""

from stickslip.catalogue.dataset import Dataset
from stickslip.catalogue.entries import dataset, names
from stickslip.catalogue.entry import Column, DataFile
from stickslip.catalogue.places import Place, cache_folder

__all__ = ["Column", "DataFile", "Dataset", "Place", "cache_folder", "dataset", "names"]
