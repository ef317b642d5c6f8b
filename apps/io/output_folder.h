/** \file
 * \brief Files that appear in a folder complete and together, or not at all.
 */
#pragma once

#include <functional>
#include <iosfwd>
#include <set>
#include <string>
#include <vector>

namespace bayesian_icp::io {

/** \brief Files on their way into a folder. Each is written under a temporary name;
 * commit() gives all of them their own. Without it nothing is left behind. */
class OutputFolder {
public:
  /** \brief Make the folder if it is missing, and see whether it can be written to.
   * \throws FileError if not */
  explicit OutputFolder(const std::string& folder);
  /** \brief Removes what was not committed, and the folder if it is new and empty. */
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder&
  operator=(const OutputFolder&) = delete;

  /** \brief The file that a name stands for: where it is a link, what that points to.
   * \throws FileError if that is there and not a regular file */
  std::string
  fileOf(const std::string& name) const;

  /** \brief Write a file under a temporary name.
   * \throws FileError if that fails, for example because the disk is full */
  void
  add(const std::string& name, const std::function<void(std::ostream&)>& write);

  /** \brief Write a file that consists of \p text. */
  void
  add(const std::string& name, const std::string& text);

  /** \brief Let \p write fill the file of the name that it is given.
   * \throws FileError if that fails */
  void
  addByName(const std::string& name,
            const std::function<void(const std::string& path)>& write);

  /** \brief Have commit() remove an older file of this name, which is not to be taken
   * for a part of what is new. A file that is added later is not left out. */
  void
  leaveOut(const std::string& name);

  /** \brief Rename what was added, replacing older files of these names. Of several
   * processes one does so after the other: the files of a run stay together.
   * \throws FileError if that fails */
  void
  commit();

private:
  struct File {
    std::string temporary_name;
    std::string name;
  };

  std::string folder_;
  /** Those that were made: the folder, and those that it is in. */
  std::vector<std::string> new_folders_;
  std::vector<File> files_;
  std::set<std::string> left_out_;
};

} // namespace bayesian_icp::io
