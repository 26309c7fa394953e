"""How far two situations of a level are apart, as its RLAs are matched."""

import numpy as np

from kurt2rt.core.planning.target import Distance, Vector
from kurt2rt.core.rla.matching import exact_distances
from kurt2rt.core.rla.space import Space
from kurt2rt.core.rla.symbol_index import edit_distances, hamming_distances


def distance_function(space: Space) -> Distance:
    """Distances in a space."""
    match space.metric:
        case "hamming":
            return lambda a, b: float(hamming_distances(a[np.newaxis], b)[0])
        case "edit":
            return lambda a, b: float(edit_distances(a[np.newaxis], b)[0])
        case "euclidean":
            weights: Vector = np.ones(space.dimensions) if space.weights is None else space.weights
            return lambda a, b: float(exact_distances((a * weights)[np.newaxis], b * weights)[0])
