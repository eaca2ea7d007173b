// Tests of the studio's access control.
#include "item3d/studio/access.h"

#include <gtest/gtest.h>

namespace item3d::testing {
namespace {

StudioAccess access_of(const std::string& password = "", const std::string& address = "") {
    return StudioAccess({"secret", password, "cookie", address});
}

std::string refusal(const std::string& host, const std::string& origin = "",
                    const std::string& address = "") {
    return access_of("", address).refusal({.host = host, .origin = origin, .changes = true});
}

TEST(StudioAccess, TakesNamesOfThisMachineAlone) {
    for (const char* host :
         {"localhost:8080", "127.0.0.1:1", "[::1]:7", "LOCALHOST", "10.0.0.7:80"})
        EXPECT_EQ(refusal(host), "") << host;
    for (const char* host : {"evil.example:8080", "", "127.0.0.1.evil.example", "localhost.evil"})
        EXPECT_NE(refusal(host), "") << host;
    EXPECT_NE(refusal("studio.example"), "");
    EXPECT_EQ(refusal("studio.example", "", "https://studio.example/mine"), "");
}

TEST(StudioAccess, TakesItsOwnOriginAlone) {
    EXPECT_EQ(refusal("localhost:80", "http://localhost:80"), "");
    EXPECT_EQ(refusal("localhost:80", "https://studio.example", "https://studio.example/mine"), "")
        << "the name of a proxy that sends its own Host";
    EXPECT_NE(refusal("localhost:80", "https://studio.example"), "");
    for (const char* origin : {"http://evil.example", "null", "http://localhost:81"})
        EXPECT_NE(refusal("localhost:80", origin), "") << origin;
    EXPECT_NE(
        access_of().refusal({.host = "localhost", .fetch_site = "cross-site", .changes = true}),
        "");
}

TEST(StudioAccess, AsksForTheToken) {
    StudioAccess access = access_of();
    EXPECT_TRUE(access.knows_token({.token = "secret"}));
    EXPECT_TRUE(access.knows_token({.cookies = "other=1; cookie=secret"}));
    for (const char* cookies : {"", "cookie=", "cookie=secre", "xcookie=secret", "cookies=secret"})
        EXPECT_FALSE(access.knows_token({.cookies = cookies})) << cookies;
    EXPECT_TRUE(access.admits("secret"));
    EXPECT_FALSE(access.admits(""));
    EXPECT_FALSE(access.admits_password("")) << "there is none";
    EXPECT_EQ(access.cookie(), "cookie=secret; HttpOnly; SameSite=Strict");
    EXPECT_NE(access_of("", "https://studio.example").cookie().find("; Secure"), std::string::npos);
}

TEST(StudioAccess, SlowsThoseWhoGuessPasswords) {
    StudioAccess access = access_of("long enough");
    EXPECT_FALSE(access.admits("secret")) << "the address alone does not open it";
    EXPECT_TRUE(access.admits_password("long enough"));
    EXPECT_FALSE(access.admits_password("long enougH"));
    EXPECT_FALSE(access.admits_password("long enough")) << "within the second behind a wrong one";
}

}  // namespace
}  // namespace item3d::testing
