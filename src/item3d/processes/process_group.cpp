#include "item3d/processes/process_group.h"

#include "item3d/core/format.h"
#include "item3d/core/progress.h"

#include <c10/util/Logging.h>
#include <nlohmann/json.hpp>

// The precompiled header lacks this definition.
#define USE_C10D_GLOO
#include <torch/csrc/distributed/c10d/PrefixStore.hpp>
#include <torch/csrc/distributed/c10d/ProcessGroupGloo.hpp>
#include <torch/csrc/distributed/c10d/TCPStore.hpp>

#include <charconv>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <thread>
#include <vector>

namespace item3d {
namespace {

using Clock = std::chrono::steady_clock;

/// Timeout of a single message. Longer waits (data preparation) use wait_for_first().
constexpr std::chrono::minutes message_timeout{30};
/// Time that process 0 waits for other processes to read its replies. A process that has died never
/// reads them.
constexpr std::chrono::seconds farewell{30};

/// Returns the first line of a message, without c10d's stack trace and advice, and without Gloo's
/// prefix "[its/source.cc:123] ".
std::string first_line(const std::string& text) {
    const std::string whole = text.substr(0, text.find('\n'));
    const std::string line = whole.substr(0, whole.find(". This is typically"));
    const std::size_t place = line.find(".cc:");
    const std::size_t end = line.find("] ");
    return line[0] == '[' && place < end && end != std::string::npos ? line.substr(end + 2) : line;
}

std::optional<std::string> variable(const char* name) {
    const char* value = std::getenv(name);
    return value && *value ? std::optional<std::string>(value) : std::nullopt;
}

int number(const char* name, int lowest, int highest, const std::string& hint) {
    const auto text = variable(name);
    if (!text) throw InputError(name, "is not set, but others of RANK and WORLD_SIZE are", hint);
    int value = 0;
    const char* end = text->data() + text->size();
    const auto [stopped, error] = std::from_chars(text->data(), end, value);
    if (error != std::errc() || stopped != end || value < lowest || value > highest)
        throw InputError(
            name,
            fmt::format("expected an integer from {} to {}, found '{}'", lowest, highest, *text),
            hint);
    return value;
}

/// Contents of the environment variables that describe the group.
struct Place {
    int rank = 0;
    int size = 1;
    std::string address;
    std::uint16_t port = 0;
    /// True if torchrun runs the store. This store survives a restart of the processes.
    bool store_is_there = false;
    std::string attempt = "0";

    std::string where() const {
        return fmt::format("MASTER_ADDR={} MASTER_PORT={}", address, port);
    }
};

Place place_from_environment() {
    const std::string hint =
        "start with torchrun, or set RANK, WORLD_SIZE, MASTER_ADDR and MASTER_PORT for each "
        "process";
    Place place;
    if (!variable("WORLD_SIZE") && !variable("RANK")) return place;
    place.size = number("WORLD_SIZE", 1, 4096, hint);
    place.rank = variable("RANK") || place.size > 1 ? number("RANK", 0, place.size - 1, hint) : 0;
    if (place.size == 1) return place;
    const auto address = variable("MASTER_ADDR");
    if (!address)
        throw InputError("MASTER_ADDR", "is not set, but WORLD_SIZE is more than 1",
                         "set it to the host name or address of process 0");
    if (!variable("MASTER_PORT"))
        throw InputError("MASTER_PORT", "is not set, but WORLD_SIZE is more than 1",
                         "set it to a free port on the machine of process 0, as in 29500");
    place.address = *address;
    place.port = static_cast<std::uint16_t>(number("MASTER_PORT", 1, 65535, hint));
    place.store_is_there = variable("TORCHELASTIC_USE_AGENT_STORE") == "True";
    place.attempt = variable("TORCHELASTIC_RESTART_COUNT").value_or("0");
    return place;
}

/// Silences c10d's log, which duplicates its exceptions, unless the user has set
/// TORCH_CPP_LOG_LEVEL.
void silence_c10d() {
    // Only fatal errors are logged.
    if (!variable("TORCH_CPP_LOG_LEVEL")) FLAGS_caffe2_log_level = 3;
}

template <class Function>
void exchange(Function&& function) {
    try {
        function();
    } catch (const std::exception& error) {
        if (interrupted())
            throw Interrupted(
                "the other processes have ended; run the same command with --resume for all of "
                "them to continue");
        throw LostProcess(first_line(error.what()));
    }
}

/// Returns the bytes of a contiguous tensor.
at::Tensor bytes_of(const at::Tensor& tensor) {
    return at::from_blob(tensor.data_ptr(), {static_cast<std::int64_t>(tensor.nbytes())},
                         at::kByte);
}

}  // namespace

LostProcess::LostProcess(const std::string& reason)
    : ResourceError(fmt::format("another process of this run ended ({}); check the messages of all "
                                "processes, then start them again with --resume",
                                reason)) {}

struct ProcessGroup::Connection {
    c10::intrusive_ptr<c10d::Store> store;
    c10::intrusive_ptr<c10d::ProcessGroupGloo> gloo;
    std::int64_t waits = 0;  ///< number of wait_for_first() calls so far
    double seconds = 0;      ///< ProcessGroup::exchange_seconds()

    void broadcast(const at::Tensor& tensor) const {
        std::vector<at::Tensor> message{tensor};
        gloo->broadcast(message)->wait();
    }
    void sum(const at::Tensor& tensor) const {
        std::vector<at::Tensor> message{tensor};
        gloo->allreduce(message)->wait();
    }
    /// Calls function() through exchange(), and adds its time to `seconds`.
    template <class Function>
    void timed(Function&& function) {
        const auto began = Clock::now();
        exchange(function);
        seconds += std::chrono::duration<double>(Clock::now() - began).count();
    }
};

ProcessGroup ProcessGroup::from_environment(std::chrono::seconds timeout) {
    const Place place = place_from_environment();
    ProcessGroup group;
    group.rank_ = place.rank;
    group.size_ = place.size;
    if (place.size == 1) return group;

    silence_c10d();
    // Writing to a process that is gone must be an error, not a signal.
    std::signal(SIGPIPE, SIG_IGN);
    const auto connection = std::make_shared<Connection>();
    const std::string hint =
        "start all processes, and check that the address is that of process 0 and that its port is "
        "free and not blocked by a firewall";
    try {
        c10d::TCPStoreOptions options;
        options.port = place.port;
        options.isServer = place.rank == 0 && !place.store_is_there;
        options.waitWorkers = false;
        options.timeout = timeout;
        connection->store = c10::make_intrusive<c10d::PrefixStore>(
            "item3d/" + place.attempt, c10::make_intrusive<c10d::TCPStore>(place.address, options));
        const auto give_up = Clock::now() + timeout;
        std::int64_t here = connection->store->add("here", 1);
        while (here < place.size && Clock::now() < give_up && !interrupted()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            here = connection->store->add("here", 0);
        }
        if (interrupted()) throw Interrupted("while waiting for the other processes");
        if (here < place.size)
            throw InputError(place.where(),
                             fmt::format("only {} of {} processes joined within {} s", here,
                                         place.size, timeout.count()),
                             hint);
        connection->gloo = c10::make_intrusive<c10d::ProcessGroupGloo>(
            connection->store, place.rank, place.size,
            c10d::ProcessGroupGloo::Options::create_default(timeout));
        connection->gloo->setTimeout(message_timeout);
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        throw InputError(place.where(),
                         fmt::format("process {} of {} cannot join the others ({})", place.rank,
                                     place.size, first_line(error.what())),
                         hint);
    }
    group.connection_ = connection;
    return group;
}

Share share_of(int rank, int size, std::int64_t total) {
    const std::int64_t first = total * rank / size;
    return {first, total * (rank + 1) / size - first};
}

void ProcessGroup::sum(at::Tensor tensor) const {
    if (!connection_ || tensor.numel() == 0) return;
    ITEM3D_CHECK(tensor.scalar_type() == at::kFloat && tensor.is_contiguous(),
                 "processes can only sum contiguous float32 tensors");
    const at::NoGradGuard no_grad;
    const at::Tensor message = tensor.cpu();  // no copy if it is there already
    connection_->timed([&] { connection_->sum(message); });
    if (!tensor.is_cpu()) tensor.copy_(message);
}

std::vector<at::Tensor> ProcessGroup::gather(const at::Tensor& tensor) const {
    at::Tensor own = tensor.detach().cpu().contiguous();
    if (!connection_ || own.numel() == 0)
        return std::vector<at::Tensor>(static_cast<std::size_t>(size_), own);
    std::vector<std::vector<at::Tensor>> all(1);
    for (int i = 0; i < size_; ++i)
        all[0].push_back(at::empty_like(own));
    connection_->timed([&] {
        std::vector<at::Tensor> message{own};
        connection_->gloo->allgather(all, message)->wait();
    });
    return all[0];
}

bool ProcessGroup::any(bool said) const {
    if (!connection_) return said;
    at::Tensor count = at::full({1}, said ? 1.0f : 0.0f);
    sum(count);
    return count.item<float>() > 0;
}

std::string ProcessGroup::broadcast(const std::string& text) const {
    if (!connection_) return text;
    std::string result = text;
    connection_->timed([&] {
        at::Tensor length = at::tensor({static_cast<std::int64_t>(text.size())});
        connection_->broadcast(length);
        result.resize(static_cast<std::size_t>(length.item<std::int64_t>()));
        if (!result.empty())
            connection_->broadcast(at::from_blob(
                result.data(), {static_cast<std::int64_t>(result.size())}, at::kByte));
    });
    return result;
}

NamedTensors ProcessGroup::broadcast(const NamedTensors& tensors) const {
    if (!connection_) return tensors;
    nlohmann::json header = nlohmann::json::array();
    for (const auto& [name, tensor] : tensors)
        if (first())
            header.push_back(nlohmann::json::array(
                {name, static_cast<int>(tensor.scalar_type()), tensor.sizes().vec()}));
    header = nlohmann::json::parse(broadcast(header.dump()));
    NamedTensors result;
    for (std::size_t i = 0; i < header.size(); ++i) {
        const auto shape = header[i][2].get<std::vector<std::int64_t>>();
        const auto dtype = static_cast<at::ScalarType>(header[i][1].get<int>());
        result.emplace_back(header[i][0].get<std::string>(),
                            first() ? tensors[i].second.contiguous() : at::empty(shape, dtype));
        if (result[i].second.numel() == 0) continue;
        connection_->timed([&] { connection_->broadcast(bytes_of(result[i].second)); });
    }
    return result;
}

void ProcessGroup::barrier() const {
    if (!connection_) return;
    connection_->timed([&] { connection_->gloo->barrier()->wait(); });
}

double ProcessGroup::exchange_seconds() const {
    return connection_ ? connection_->seconds : 0;
}

void ProcessGroup::wait_for_first() const {
    if (!connection_) return;
    exchange([&] {
        const std::string key = fmt::format("first/{}", connection_->waits++);
        if (first()) connection_->store->set(key, std::vector<std::uint8_t>{1});
        // A blocked receive cannot be interrupted, so the store is polled.
        const auto ask_until = [&](auto&& answered) {
            while (!answered()) {
                if (interrupted()) throw std::runtime_error("interrupted");
                std::this_thread::sleep_for(std::chrono::milliseconds(50));
            }
        };
        ask_until([&] { return connection_->store->check({key}); });
        // The store belongs to process 0, which must not end before all have read its reply.
        const std::string seen = key + "/seen";
        connection_->store->add(seen, 1);
        const auto give_up = Clock::now() + farewell;
        if (first())
            ask_until([&] {
                return connection_->store->add(seen, 0) >= size_ || Clock::now() > give_up;
            });
    });
}

}  // namespace item3d
