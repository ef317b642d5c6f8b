/** \file
 * \brief Options that are one of a few named values.
 */
#pragma once

#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief All values 0, 1, ... of an enumeration that its toString() names. */
template <typename Choice>
std::vector<Choice>
choicesOf(Choice)
{
  std::vector<Choice> choices;
  for (int i = 0; toString(static_cast<Choice>(i)) != std::string("unknown"); ++i)
    choices.push_back(static_cast<Choice>(i));
  return choices;
}

/** \brief "one, two or three". */
template <typename Choice>
std::string
namesOfChoices(Choice choice)
{
  const auto choices = choicesOf(choice);
  std::string names;
  for (std::size_t i = 0; i < choices.size(); ++i)
    names += (i == 0                   ? ""
              : i + 1 < choices.size() ? ", "
                                       : " or ") +
             std::string(toString(choices[i]));
  return names;
}

/** \brief Set \p choice to the value of this name.
 * \return whether there is one */
template <typename Choice>
bool
readChoice(const std::string& name, Choice& choice)
{
  for (const Choice candidate : choicesOf(choice))
    if (name == toString(candidate)) {
      choice = candidate;
      return true;
    }
  return false;
}

} // namespace bayesian_icp::app
