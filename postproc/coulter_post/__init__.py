"""Read and draw the results of Coulter."""

from .results import Boundary, Frame, Grid, Results

__all__ = ["Boundary", "Frame", "Grid", "Results"]
