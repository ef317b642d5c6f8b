/** \file
 * \brief Files of results, one row per run, in which runs are found by their name.
 *
 * A type of rows says its columns once: `run.columns(column)` calls `column(title,
 * value)` for each, in their order, to read and to write; the values are std::string,
 * bool (0 or 1) or numbers. `Run::name` is what tells runs apart, and has the first
 * `Run::num_name_columns` of them. A last column has the version of this program: a
 * file of another one is refused.
 */
#pragma once

#include "io/coordinates.h"
#include "io/errors.h"
#include "io/line_file.h"
#include "io/numbers.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <deque>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief A row of a CSV file, without quoting, in the making. */
class CsvRow {
public:
  /** \brief Add a field. Commas and control characters of a text become spaces; a bool
   * is 0 or 1. */
  template <typename Value>
  CsvRow&
  add(const Value& value)
  {
    if (!is_empty_)
      text_ += ',';
    is_empty_ = false;
    if constexpr (std::is_same_v<Value, bool>)
      text_ += value ? '1' : '0';
    else if constexpr (std::is_arithmetic_v<Value>)
      text_ += io::textOf(value);
    else
      addText(value);
    return *this;
  }

  const std::string&
  text() const
  {
    return text_;
  }

private:
  void
  addText(const std::string& text)
  {
    for (const char character : text) {
      const bool is_plain =
          character != ',' && static_cast<unsigned char>(character) >= 0x20;
      text_ += is_plain ? character : ' ';
    }
  }

  std::string text_;
  bool is_empty_ = true;
};

namespace detail {

inline void
readField(std::string_view text, std::string& value)
{
  value = text;
}

inline void
readField(std::string_view text, bool& value)
{
  if (text != "0" && text != "1")
    throw std::runtime_error("neither 0 nor 1");
  value = text == "1";
}

template <typename Number>
void
readField(std::string_view text, Number& value)
{
  if (!io::readNumber(text, value))
    throw std::runtime_error("not a number");
}

} // namespace detail

/** \brief The titles of the columns. */
template <typename Run>
std::string
headerOf()
{
  CsvRow row;
  Run().columns([&row](const std::string& title, const auto&) { row.add(title); });
  return row.text();
}

/** \brief The values. */
template <typename Run>
std::string
rowOf(Run run)
{
  CsvRow row;
  run.columns([&row](const std::string&, const auto& value) { row.add(value); });
  return row.text();
}

/** \brief Read a row.
 * \throws std::runtime_error if the line is not a row */
template <typename Run>
Run
runOf(const std::string& line)
{
  const std::vector<std::string_view> fields = io::splitAt(',', line);
  std::size_t place = 0;
  Run run;
  run.columns([&](const std::string&, auto& value) {
    if (place == fields.size())
      throw std::runtime_error("too few fields");
    detail::readField(fields[place++], value);
  });
  if (place < fields.size())
    throw std::runtime_error("too many fields");
  return run;
}

/** \brief Components of a twist, as titles of columns have them. */
constexpr std::array<const char*, 6> twist_names = {"vx", "vy", "vz", "wx", "wy", "wz"};

/** \brief Columns of the six coordinates of a pose, or of others by their names. */
template <typename Vector, typename Column>
void
coordinateColumns(const std::string& prefix,
                  Vector& values,
                  const Column& column,
                  const std::array<const char*, 6>& names = app::coordinate_names)
{
  for (std::size_t k = 0; k < names.size(); ++k)
    column(prefix + names[k], values[Eigen::Index(k)]);
}

/** \brief The same with the coordinates' units in the titles. */
template <typename Vector, typename Column>
void
unitColumns(const std::string& prefix, Vector& values, const Column& column)
{
  for (std::size_t k = 0; k < 6; ++k)
    column(prefix + app::coordinateKey(k), values[Eigen::Index(k)]);
}

/** \brief A CSV file of runs that grows by one row per run, so an interrupted study
 * continues where it stopped. For one process at a time, and any of its threads. */
template <typename Run>
class RunFile {
public:
  using Name = decltype(Run::name);

  /** \brief Read what is there, or write the header; a last line that was cut off is
   * removed.
   * \throws io::FileError if the file exists and has another header, a row of another
   *         version or a bad one, or cannot be written, or is in use by another process
   */
  explicit RunFile(const std::string& file)
  : file_(file, [&, has_header = false](const std::string& line) mutable {
    if (!has_header && line != header())
      refuse(file);
    if (has_header)
      read(line, file);
    return has_header = true;
  })
  {
    if (file_.isNew())
      file_.add(header());
  }

  /** \brief The run of this name, or null; valid as long as this object. */
  const Run*
  find(const Name& name) const
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = places_.find(keyOf(name));
    return found == places_.end() ? nullptr : &runs_[found->second];
  }

  /** \brief Write a row, at once.
   * \return the run, valid as long as this object
   * \throws io::FileError */
  const Run&
  add(const Run& run)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    file_.add(rowOf(run) + version_field);
    return keep(run);
  }

  /** \brief The run of this name: that of the file, or the one that \p make returns,
   * which is added to it. */
  template <typename Make>
  const Run&
  findOrMake(const Name& name, const Make& make)
  {
    const Run* const known = find(name);
    return known != nullptr ? *known : add(make());
  }

  /** \brief In the order in which they ended. */
  std::vector<Run>
  runs() const
  {
    return {runs_.begin(), runs_.end()};
  }

private:
  static constexpr char version_field[] = "," BAYESIAN_ICP_VERSION;

  static std::string
  header()
  {
    return headerOf<Run>() + ",version";
  }

  [[noreturn]] static void
  refuse(const std::string& file)
  {
    throw io::FileError(file,
                        "is not a file of results of version " BAYESIAN_ICP_VERSION
                        ": move it away, or choose another --output");
  }

  void
  read(const std::string& line, const std::string& file)
  {
    const std::size_t end = std::min(line.rfind(','), line.size());
    if (line.substr(end) != version_field)
      refuse(file);
    try {
      keep(runOf<Run>(line.substr(0, end)));
    }
    catch (const std::exception&) {
      throw io::FileError(file, "bad line '" + line + "'");
    }
  }

  static std::string
  keyOf(const Name& name)
  {
    Run run;
    run.name = name;
    CsvRow key;
    int num_left = Run::num_name_columns;
    run.columns([&](const std::string&, const auto& value) {
      if (num_left-- > 0)
        key.add(value);
    });
    return key.text();
  }

  const Run&
  keep(const Run& run)
  {
    const auto [place, is_new] = places_.emplace(keyOf(run.name), runs_.size());
    if (is_new)
      return runs_.emplace_back(run);
    return runs_[place->second] = run;
  }

  std::deque<Run> runs_;
  std::map<std::string, std::size_t> places_;
  mutable std::mutex mutex_;
  io::LineFile file_;
};

} // namespace bayesian_icp::evaluate
