"""Numbers, colours and values as text in a page are those of the window: the JavaScript against the Python."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from playground import api
from playground.live import dome
from playground.sketch.assign import TERRAIN_KEYS, check_value
from playground.sketch.colour import parse_hex, to_hex
from playground.sketch.described_parameter import described
from playground.sketch.model import Camera, Parameter, Sketch
from playground.sketch.parameter import Widget
from playground.sketch.values import coerce, is_whole, length_of, tidied
from playground.sketch.values import write as written
from playground.workbench import number_format
from playground.workbench.camera_drag import HALF_TURN, Gesture, steered
from playground.workbench.framing import field_for
from playground.workbench.inspect.time_range import stepped
from playground.workbench.parameter_list import Listing
from playground.workbench.sun_drag import turned

from .node import Node
