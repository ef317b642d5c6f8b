/** \file
 * \brief Things that have a name.
 */
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Their names, in their order. */
template <typename Thing>
std::vector<std::string>
namesOf(const std::vector<Thing>& things)
{
  std::vector<std::string> names;
  for (const Thing& thing : things)
    names.push_back(thing.name);
  return names;
}

/** \brief The first one of this name, or null. */
template <typename Thing>
const Thing*
findNamed(const std::vector<Thing>& things, const std::string& name)
{
  const auto found = std::find_if(
      things.begin(), things.end(), [&](const Thing& t) { return t.name == name; });
  return found == things.end() ? nullptr : &*found;
}

} // namespace bayesian_icp::evaluate
