/** \file
 * \brief A CSV file that grows by a row a run, so that an interrupted study goes on
 * where it stopped.
 */
#pragma once

#include <functional>
#include <string>

namespace bayesian_icp::evaluate {

/** \brief Rows of text below a header. */
class RowFile {
public:
  /** \brief Read what is there; a last line that was cut off is dropped.
   * \param[in] read_row gets each row; throws any std::exception if it is not one
   * \throws io::FileError if the file exists and has another header or a bad row, or
   *         cannot be written */
  RowFile(const std::string& name,
          const std::string& header,
          const std::function<void(const std::string& row)>& read_row);

  /** \brief Write a row, at once.
   * \throws io::FileError */
  void
  add(const std::string& row) const;

private:
  /** Replace the whole file, completely or not at all. */
  void
  rewrite(const std::string& text) const;

  std::string file_;
};

} // namespace bayesian_icp::evaluate
