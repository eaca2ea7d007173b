// The pages that are shown before the studio's own.
#pragma once

#include <string>

namespace item3d {

/// A form that asks for the password. problem: said above it, or empty.
std::string login_page(const std::string& problem);
std::string refused_page(const std::string& why);
/// The field of login_page()'s form.
std::string password_of_form(const std::string& body);

/// The Content-Security-Policy of a page: what it loads is this server's, and of scripts within it
/// only those that it has now.
std::string page_policy(const std::string& page);

}  // namespace item3d
