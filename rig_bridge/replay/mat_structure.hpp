/// Whether the lengths that a MATLAB file claims are those of what it holds. To be asked before libmatio reads one: it reserves, and
/// clears, whatever length a damaged file claims.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace rig::replay {

/// What is said, after its name, of a file that is none.
inline constexpr const char* kNoMat = ": cannot be read as a MATLAB file (v4, v5, or v7.3 where matio has HDF5)";

/// Walks over every element of a file of version 4 or 5 (compressed ones are inflated, none is kept) and throws std::runtime_error with
/// `name`, the byte and what is wrong there: an element longer than what is around it, values that are not as many as the dimensions say,
/// nesting deeper than 32. A file of version 7.3 is HDF5, whose library looks after its own lengths: accepted as it is.
void check_mat_structure(const std::string& name, std::span<const unsigned char> file);

}  // namespace rig::replay
