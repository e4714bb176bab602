# SPDX-License-Identifier: BSD-3-Clause
from ._core import Errors as Errors
from ._core import Statistics as Statistics
from ._core import ate as ate
from ._core import rpe as rpe
