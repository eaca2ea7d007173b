"""Generates shell completions from the descriptions of the commands (see scripts/reference.py)."""
import re


def long_names(option):
    return re.findall(r"--[\w-]+", option["names"])


def choices(option):
    """Returns the possible values of an option, or an empty list if its value is free."""
    value = option["value"]
    return value.split("|") if "|" in value and value == value.lower() else []


def takes_path(option):
    return option["positional"] or any(word in option["value"] for word in ("FILE", "FOLDER", "LIGHT", "PRIOR"))


def with_own_commands(commands):
    for command in commands:
        yield command
        yield from with_own_commands(command["commands"])


def words_of(command):
    return " ".join(command["name"].split()[1:])


BASH = r"""# Completion of item3d for bash.
_item3d() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} command=${COMP_WORDS[1]} options='' commands=''
    if [ "$COMP_CWORD" = 1 ]; then
        COMPREPLY=($(compgen -W "%(first)s --help --version" -- "$word"))
        return
    fi
    case "$command ${COMP_WORDS[2]}" in
%(pairs)s
    esac
    case "$command $before" in
%(choices)s
    esac
    case $command in
%(commands)s
    esac
    if [[ $word == -* ]]; then
        COMPREPLY=($(compgen -W "$options" -- "$word"))
    elif [ "$COMP_CWORD" = 2 ] && [ -n "$commands" ]; then
        COMPREPLY=($(compgen -W "$commands" -- "$word"))
    else
        compopt -o filenames 2>/dev/null
        COMPREPLY=($(compgen -f -- "$word"))
    fi
}
complete -F _item3d item3d
"""


def bash(commands):
    everything = list(with_own_commands(commands))
    pairs = "\n".join(f"        '{words_of(c)}') command='{words_of(c)}' ;;" for c in everything if len(c["name"].split()) > 2)
    values = "\n".join(
        f"        {' | '.join(repr(words_of(c) + ' ' + name) for name in long_names(option))}) COMPREPLY=($(compgen -W '{' '.join(choices(option))}' -- \"$word\")); return ;;"
        for c in everything for option in c["options"] if choices(option) and long_names(option))
    cases = "\n".join(
        f"        '{words_of(c)}') options='{' '.join(name for option in c['options'] for name in long_names(option))}'"
        f" commands='{' '.join(words_of(sub).split()[-1] for sub in c['commands'])}' ;;" for c in everything)
    return BASH % {"first": " ".join(words_of(c) for c in commands), "pairs": pairs, "choices": values, "commands": cases}


def quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def zsh_option(option):
    text = re.sub(r"([\[\]:])", r"\\\1", option["description"])
    value = ""
    if option["value"]:
        values = choices(option)
        value = ":" + re.sub(r"([\[\]:])", r"\\\1", option["value"]) + ":" + (f"({' '.join(values)})" if values else "_files" if takes_path(option) else "")
    repeat = "*" if option["repeated"] else ""
    return [quoted(f"{repeat}{name}[{text}]{value}") for name in long_names(option)]


def zsh(commands):
    lines = ["#compdef item3d", "# Completion of item3d for zsh.", "_item3d() {", "  local -a commands", "  if (( CURRENT == 2 )); then", "    commands=("]
    lines += [f"      {quoted(words_of(c) + ':' + c['description'].replace(':', ' '))}" for c in commands]
    lines += ["    )", "    _describe command commands", "    return", "  fi", "  local name=$words[2]", "  shift words; (( CURRENT-- ))"]
    lines += ['  case "$name $words[2]" in']
    lines += [f"    {quoted(words_of(c))}) name={quoted(words_of(c))}; shift words; (( CURRENT-- )) ;;" for c in with_own_commands(commands) if len(c["name"].split()) > 2]
    lines += ["  esac", '  case $name in']
    for c in with_own_commands(commands):
        lines.append(f"    {quoted(words_of(c))})")
        subs = [quoted(words_of(sub).split()[-1] + ":" + sub["description"].replace(":", " ")) for sub in c["commands"]]
        if subs:
            lines += [f"      if (( CURRENT == 2 )); then commands=({' '.join(subs)}); _describe command commands; fi"]
        lines += ["      _arguments \\"] + [f"        {text} \\" for option in c["options"] for text in zsh_option(option)] + ["        '*:file:_files' ;;"]
    return "\n".join(lines + ["  esac", "}", '_item3d "$@"']) + "\n"


def fish(commands):
    lines = ["# Completion of item3d for fish.", "complete -c item3d -n __fish_use_subcommand -l version -d 'Print the version'"]
    for c in commands:
        lines.append(f"complete -c item3d -f -n __fish_use_subcommand -a {words_of(c)} -d {quoted(c['description'])}")
    for c in with_own_commands(commands):
        words = words_of(c).split()
        seen = quoted("; and ".join(f"__fish_seen_subcommand_from {word}" for word in words))
        for sub in c["commands"]:
            lines.append(f"complete -c item3d -f -n {seen} -a {words_of(sub).split()[-1]} -d {quoted(sub['description'])}")
        for option in c["options"]:
            values = choices(option)
            value = f" -x -a {quoted(' '.join(values))}" if values else " -r -F" if option["value"] and takes_path(option) else " -x" if option["value"] else ""
            lines += [f"complete -c item3d -n {seen} -l {name[2:]}{value} -d {quoted(option['description'])}" for name in long_names(option)]
    return "\n".join(lines) + "\n"


def completions(commands):
    """Returns the contents of the completion files, by their paths in share/."""
    return {"bash-completion/completions/item3d": bash(commands), "zsh/site-functions/_item3d": zsh(commands),
            "fish/vendor_completions.d/item3d.fish": fish(commands)}
