#include "item3d/core/interrupt.h"

#include "item3d/core/progress.h"

#include <signal.h>

#include <atomic>
#include <csignal>

namespace item3d {
namespace {

// Set by the signal handler, which has only global state.
std::atomic<bool> wanted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

void on_interrupt(int signal) {
    // Schedulers may send SIGTERM several times, and a closed terminal sends SIGHUP. So only a
    // second Ctrl-C ends the program immediately.
    const bool is_second = wanted.exchange(true);
    if (!is_second || signal != SIGINT) return;
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

}  // namespace

void install_interrupt_handler() {
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
    // SIGHUP stays ignored if it is ignored already, as it is under nohup.
    struct sigaction hangup = {};
    if (::sigaction(SIGHUP, nullptr, &hangup) == 0 && hangup.sa_handler != SIG_IGN)
        std::signal(SIGHUP, on_interrupt);
}

void request_interrupt() {
    wanted = true;
}

bool interrupted() {
    return wanted;
}

}  // namespace item3d
