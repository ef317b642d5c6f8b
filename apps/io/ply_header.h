/** \file
 * \brief The header of a PLY file.
 */
#pragma once

#include "io/input_file.h"

#include <cstdint>
#include <string>
#include <vector>

namespace bayesian_icp::io {

/** \brief A line `property`. */
struct PlyProperty {
  std::string name;
  /** Of the number or, in a list, of its length. */
  std::string type;
  bool is_list = false;
};

/** \brief A kind of thing in the file, such as "vertex". */
struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
  /** Least number of bytes in the binary formats: an empty list is but its length. */
  std::uint64_t min_bytes = 0;
  bool has_list = false;
};

/** \brief What is in the file, in its order. */
struct PlyHeader {
  bool is_ascii = false;
  std::vector<PlyElement> elements;
  std::uint64_t num_points = 0;
};

/** \brief Read the header, leaving \p file at the first byte of the points.
 * \return a header with at least one point, which PCL reads as it is meant
 * \throws FileError if it is not, or not a complete, consistent PLY header */
PlyHeader
readPlyHeader(InputFile& file);

} // namespace bayesian_icp::io
