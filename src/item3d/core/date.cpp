#include "item3d/core/date.h"

#include "item3d/core/error.h"

#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <string_view>

namespace item3d {
namespace {

/// The last second whose year has four digits: 9999-12-31T23:59:59Z.
constexpr std::int64_t last_second = 253402300799;

std::time_t now() {
    const char* given = std::getenv("SOURCE_DATE_EPOCH");
    if (given == nullptr) return std::time(nullptr);
    const std::string_view text = given;
    std::int64_t seconds = -1;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
    if (error != std::errc() || end != text.data() + text.size() || seconds < 0 ||
        seconds > last_second)
        throw InputError("SOURCE_DATE_EPOCH",
                         "is '" + std::string(text) + "', expected seconds since 1970",
                         "set it to a number, or unset it");
    return static_cast<std::time_t>(seconds);
}

}  // namespace

std::string utc_date() {
    const std::time_t seconds = now();
    std::tm date{};
    gmtime_r(&seconds, &date);
    char text[sizeof "2026-11-27T15:04:05Z"];
    const std::size_t size = std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &date);
    return {text, size};
}

}  // namespace item3d
