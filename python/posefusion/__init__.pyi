# SPDX-License-Identifier: BSD-3-Clause
from . import evaluate as evaluate
from ._core import Camera as Camera
from ._core import Errors as Errors
from ._core import Frame as Frame
from ._core import InputError as InputError
from ._core import Map as Map
from ._core import Recording as Recording
from ._core import Result as Result
from ._core import Slam as Slam
from ._core import Statistics as Statistics
from ._core import open_folder as open_folder
from ._core import read_tum as read_tum
from ._core import write_tum as write_tum
