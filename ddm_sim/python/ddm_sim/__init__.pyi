# Type hints of the Python interface of ddm_sim.
# SPDX-License-Identifier: BSD-3-Clause
from typing import Any, Dict, Optional, Tuple

import numpy as np

class Environment:
    observation_space: Any
    action_space: Any
    dt: float
    max_steps: int
    configuration: Dict[str, Dict[str, Any]]
    def reset(self, *, seed: Optional[int] = ..., options: Optional[Dict[str, Any]] = ...) -> Tuple[np.ndarray, Dict[str, Any]]: ...
    def step(self, torque: np.ndarray) -> Tuple[np.ndarray, float, bool, bool, Dict[str, Any]]: ...
    def render(self) -> np.ndarray: ...
    def close(self) -> None: ...

def make(plant: str, /, **options: Any) -> Environment: ...
