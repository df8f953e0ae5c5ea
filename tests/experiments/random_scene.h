#pragma once

#include <string>

namespace cradle {

/// Text of a scene of one second thrown together: some bodies of any shape, springs, ropes, rods, ball joints and
/// hinges between them, fixed things to fall onto. The same for the same number, whatever was asked for before.
/// Accuracies of 1e-3, 1e-5 and 1e-7 take turns; no two bodies overlap at the start, and nothing pushes, so that energy
/// may only go.
std::string randomSceneText(unsigned number);

}  // namespace cradle
