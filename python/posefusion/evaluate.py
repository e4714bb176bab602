# SPDX-License-Identifier: BSD-3-Clause
"""Errors of trajectories as the tool evo computes them."""
from posefusion._core import Errors, Statistics, ate, rpe

__all__ = ["Errors", "Statistics", "ate", "rpe"]
