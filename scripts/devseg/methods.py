"""The methods that the command line offers, as the filters declare them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, cast

from devseg.methods_table import TABLE


@dataclass(frozen=True)
class Method:
    """A segmentation method.

    Attributes:
        name: word of the command line.
        filter: name of the filter.
        parameters: of the filter.
        options: options of the command line and the filter parameters they set; an option that
            is not here does not apply to the method.
        deforms: whether the charts are deformed until they can be unfolded exactly.
        preset: of the pattern, unless another one is asked for.
        flatten: key of FLATTENINGS that `devseg run` takes without --flatten.
        bounds_material: whether a material sets the strain that its charts may have.
    """

    name: str
    filter: str
    parameters: tuple[str, ...]
    options: Mapping[str, str]
    deforms: bool
    preset: str | None
    flatten: str
    bounds_material: bool = False


# The options of the command line that a method may take, and the filter parameters they set.
_OPTIONS = {
    "charts": "charts_number",
    "max_l2_stretch": "max_l2_stretch",
    "max_linf_stretch": "max_linf_stretch",
    "max_fitting_error": "max_fitting_error",
    "slit_threshold": "slit_threshold",
    "max_net_faces": "max_net_faces",
    "seed": "random_seed",
    "max_iterations": "max_iterations",
}
METHOD_OPTIONS = tuple(_OPTIONS)
# The other way round, as users know them.
OPTION_OF = {parameter: f"--{name.replace('_', '-')}" for name, parameter in _OPTIONS.items()}

METHODS = {
    name: Method(
        name,
        row["filter"],
        tuple(row["parameters"]),
        {option: of for option, of in _OPTIONS.items() if of in row["parameters"]},
        row["deforms"],
        row["preset"],
        row["flatten"],
        "material" in row["parameters"],
    )
    for name, row in cast("dict[str, dict[str, Any]]", TABLE).items()
}

# Methods whose seams may leave the mesh's edges; the others' charts are made of whole faces.
SMOOTH_METHODS = ("dcharts", "t-flooding", "plush")

# Words of --flatten and the values of the filter's parameter "method".
FLATTENINGS = {
    "symmetric-dirichlet": "Symmetric Dirichlet",
    "lscm": "LSCM",
    "abf": "ABF++",
    "arap": "ARAP",
    "lpfb": "LPFB",
    "lpfb-even-areas": "LPFB Even Areas",
}

# Words of --effort and the values of the filters' parameter "effort".
EFFORTS = {"fast": "Fast", "normal": "Normal", "best": "Best"}
