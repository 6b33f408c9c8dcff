"""The methods that the command line offers: one entry each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Method:
    """A segmentation method.

    Attributes:
        name: word of the command line.
        filter: name of the filter.
        options: options of the command line and the filter parameters they set; an option that
            is not here does not apply to the method.
        deforms: whether the charts are deformed until they can be unfolded exactly.
        preset: of the pattern, unless another one is asked for.
        flatten: key of FLATTENINGS that `devseg run` takes without --flatten.
    """

    name: str
    filter: str
    options: Mapping[str, str]
    deforms: bool = False
    preset: str | None = None
    flatten: str = "symmetric-dirichlet"


# Every segmentation filter has these.
_COMMON = {"seed": "random_seed", "max_iterations": "max_iterations"}

METHODS = {
    method.name: method
    for method in (
        Method(
            "dcharts",
            "compute_segmentation_dcharts_per_face",
            {
                "charts": "charts_number",
                "max_l2_stretch": "max_l2_stretch",
                "max_linf_stretch": "max_linf_stretch",
                "max_fitting_error": "max_fitting_error",
                **_COMMON,
            },
        ),
        Method(
            "t-flooding",
            "compute_segmentation_t_flooding_per_face",
            {"charts": "charts_number", **_COMMON},
        ),
        Method(
            "papercraft",
            "compute_segmentation_papercraft_per_face",
            {"charts": "charts_number", "slit_threshold": "slit_threshold", **_COMMON},
            deforms=True,
            preset="papercraft",
        ),
        Method(
            "plush",
            "compute_segmentation_plush_seams_per_face",
            {**_COMMON},
            flatten="lpfb",
        ),
        Method(
            "vsa",
            "compute_segmentation_variational_shape_approximation_per_face",
            {"charts": "charts_number", **_COMMON},
        ),
        Method(
            "mcgim",
            "compute_segmentation_multi_chart_geometry_images_per_face",
            {"charts": "charts_number", **_COMMON},
        ),
    )
}

# Words of --flatten and the values of the filter's parameter "method".
FLATTENINGS = {
    "symmetric-dirichlet": "Symmetric Dirichlet",
    "lscm": "LSCM",
    "abf": "ABF++",
    "arap": "ARAP",
    "lpfb": "LPFB",
}

# The options of the command line that a method may take.
METHOD_OPTIONS = (
    "charts",
    "max_l2_stretch",
    "max_linf_stretch",
    "max_fitting_error",
    "slit_threshold",
    "seed",
    "max_iterations",
)
