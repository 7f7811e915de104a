// SPDX-License-Identifier: MIT-0
#pragma once

#include <pybind11/pybind11.h>

/// Adds guides whose h is a function in Python: `_trellis.function_guide`, and the class Known. The module has the
/// class Guide already.
void add_function_guides(pybind11::module_& module);
