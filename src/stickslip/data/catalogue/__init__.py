"""The data catalogue: public friction records, where they come from, and their tidy tables."""

from stickslip.data.catalogue.dataset import (
    CacheLocation,
    Column,
    DataFile,
    Dataset,
    cache_folder,
    dataset,
    names,
)

__all__ = ["CacheLocation", "Column", "DataFile", "Dataset", "cache_folder", "dataset", "names"]


def __dir__() -> list[str]:
    return sorted(__all__)
