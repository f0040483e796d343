# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.data.catalogue.datasets import CacheLocation as CacheLocation
from stickslip.data.catalogue.datasets import Column as Column
from stickslip.data.catalogue.datasets import DataFile as DataFile
from stickslip.data.catalogue.datasets import Dataset as Dataset
from stickslip.data.catalogue.datasets import cache_folder as cache_folder
from stickslip.data.catalogue.datasets import dataset as dataset
from stickslip.data.catalogue.datasets import names as names

__all__ = [
    "CacheLocation",
    "Column",
    "DataFile",
    "Dataset",
    "cache_folder",
    "dataset",
    "names",
]
