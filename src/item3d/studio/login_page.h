// Login page of the studio, and the content security policy of a page.
#pragma once

#include <string>

namespace item3d {

/// Returns a page with a form for the password. problem: message above the form, or empty.
std::string login_page(const std::string& problem);
std::string refused_page(const std::string& why);
/// Returns the password in a body that login_page()'s form sent.
std::string password_of_form(const std::string& body);

/// Returns the Content-Security-Policy of a page. It permits only resources of this server, and
/// only the inline scripts that the page has now.
std::string page_policy(const std::string& page);

}  // namespace item3d
