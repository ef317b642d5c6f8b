#include "io/interrupt.h"

#include <csignal>

namespace bayesian_icp::io {

namespace {

constexpr int signals[] = {SIGINT, SIGTERM};

volatile std::sig_atomic_t was_interrupted = 0;

bool
isIgnored(int signal)
{
  struct sigaction action = {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

void
handleBy(void (*handler)(int))
{
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  for (const int signal : signals)
    if (!isIgnored(signal))
      sigaction(signal, &action, nullptr);
}

void
remember(int)
{
  was_interrupted = 1;
  handleBy(SIG_DFL);
}

} // namespace

void
catchInterrupt()
{
  handleBy(remember);
}

bool
wasInterrupted()
{
  return was_interrupted != 0;
}

} // namespace bayesian_icp::io
