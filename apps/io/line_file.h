/** \file
 * \brief A text file that grows by whole lines, so that a run that was killed goes on
 * where it stopped.
 */
#pragma once

#include <functional>
#include <string>

namespace bayesian_icp::io {

/** \brief Lines on the disk, written by one process at a time. */
class LineFile {
public:
  /** \brief Open \p name, or make it and its folder, keep other processes from it, and
   * read what is there. A last line that was cut off is removed.
   * \param[in] read_line gets each complete line, without its line break, and returns
   *            whether it stays in the file
   * \throws FileError if the file cannot be written, is in use by another process or
   *         has text but no complete line, and what \p read_line throws */
  LineFile(const std::string& name,
           const std::function<bool(const std::string& line)>& read_line);
  ~LineFile();
  LineFile(const LineFile&) = delete;
  LineFile&
  operator=(const LineFile&) = delete;

  /** \brief Whether there was no line when the file was opened. */
  bool
  isNew() const
  {
    return is_new_;
  }

  /** \brief Append a line, at once and completely.
   * \throws FileError if that fails, for example because the disk is full; the file is
   *         then as it was */
  void
  add(const std::string& line) const;

private:
  LineFile(const std::string& name, int descriptor);

  /** Remove what follows the first \p size bytes. */
  void
  cutTo(long size) const;

  std::string name_;
  int descriptor_;
  bool is_new_ = false;
};

} // namespace bayesian_icp::io
