#include "item3d/serve/secret.h"

#include "item3d/core/error.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace item3d {

std::string random_secret(int bytes) {
    std::array<unsigned char, 64> values{};
    const auto count = static_cast<std::size_t>(bytes);
    ITEM3D_CHECK(count <= values.size(), "a secret of so many bytes");
    if (::getrandom(values.data(), count, 0) != static_cast<ssize_t>(count))
        throw ResourceError(std::string("the system provides no random numbers: ") +
                            std::strerror(errno));
    std::string secret;
    for (std::size_t i = 0; i < count; ++i)
        secret += fmt::format("{:02x}", values[i]);
    return secret;
}

bool equals_secret(const std::string& given, const std::string& secret) {
    if (given.size() != secret.size()) return false;
    unsigned difference = 0;
    for (std::size_t i = 0; i < secret.size(); ++i)
        difference |= static_cast<unsigned char>(given[i]) ^ static_cast<unsigned char>(secret[i]);
    return difference == 0;
}

}  // namespace item3d
