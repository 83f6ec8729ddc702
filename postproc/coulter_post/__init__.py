"""Read and draw the results of Coulter."""

from .results import Boundary, Frame, Grid, Results, Stations

__all__ = ["Boundary", "Frame", "Grid", "Results", "Stations"]
