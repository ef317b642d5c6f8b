/** \file
 * \brief The header of a PCD file.
 */
#pragma once

#include "io/input_file.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace bayesian_icp::io {

/** \brief What separates the words of a line, for PCL. */
constexpr const char* pcd_separators = " \t\r";

/** \brief One field of every point, as in the lines FIELDS, SIZE, TYPE and COUNT. */
struct PcdField {
  std::string name;
  std::uint32_t size = 0;
  char type = 0;
  std::uint32_t count = 1;
};

/** \brief What the points are and how they are stored. */
struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t num_points = 0;
  /** "ascii", "binary" or "binary_compressed". */
  std::string encoding;

  /** \brief Numbers a point has, padding included. */
  std::uint64_t
  numValues() const
  {
    std::uint64_t sum = 0;
    for (const PcdField& field : fields)
      sum += field.count;
    return sum;
  }

  /** \brief Size of a point in the binary encodings. */
  std::uint64_t
  numBytesPerPoint() const
  {
    std::uint64_t sum = 0;
    for (const PcdField& field : fields)
      sum += std::uint64_t(field.size) * field.count;
    return sum;
  }
};

/** \brief Whether PCL takes a line with this first word for one of the header. */
bool
beginsWithPcdKey(std::string_view word);

/** \brief Read the header, leaving \p file at the first byte of the points.
 * \return a header with at least one point, every field of a size that PCL knows
 * \throws FileError if it is not a complete, consistent PCD header */
PcdHeader
readPcdHeader(InputFile& file);

} // namespace bayesian_icp::io
