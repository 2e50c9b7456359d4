/// Checks the lengths stated in a MATLAB file against its content. Call before libmatio reads the file: it allocates and clears any length that a
/// damaged file states.
#pragma once

#include <span>
#include <string>

namespace rig::replay {

/// Error text, after the file's name, for a file that is not a MATLAB file.
inline constexpr const char* kNoMat = ": cannot be read as a MATLAB file (v4, v5, or v7.3 where matio has HDF5)";

/// Walks over every element of a file of version 4 or 5 (compressed ones are inflated, none is kept) and throws std::runtime_error with
/// `name`, the byte and what is wrong there: an element longer than its container, a number of values that contradicts the dimensions, nesting deeper
/// than 32. A file of version 7.3 is HDF5, whose library checks lengths itself, and is accepted unchecked.
void check_mat_structure(const std::string& name, std::span<const unsigned char> file);

}  // namespace rig::replay
