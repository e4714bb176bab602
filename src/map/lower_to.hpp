// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pf {

/// Lowers an integer to `value` where that is less. Threads may call it at once: the least stays,
/// whichever comes first.
template <typename Integer>
void lowerTo(Integer* cell, Integer value) {
  Integer old = __atomic_load_n(cell, __ATOMIC_RELAXED);
  while (value < old && !__atomic_compare_exchange_n(cell, &old, value, true, __ATOMIC_RELAXED,
                                                     __ATOMIC_RELAXED)) {
  }
}

}  // namespace pf
