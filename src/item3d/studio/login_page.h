// Login page of the studio, and the content security policy of a page.
#pragma once

#include <string>

namespace item3d {

/// Returns a form for the password. problem: message above it, or empty.
std::string login_page(const std::string& problem);
std::string refused_page(const std::string& why);
/// Returns the field of login_page()'s form.
std::string password_of_form(const std::string& body);

/// Returns the Content-Security-Policy of a page: resources of this server only, and only the
/// inline scripts that the page has now.
std::string page_policy(const std::string& page);

}  // namespace item3d
