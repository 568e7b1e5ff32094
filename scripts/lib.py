"""What the verbs in Python share, as lib.sh for the others: help, errors, and output that cannot be written."""
import os
import sys


def help_text(file):
    """The header comment of a verb."""
    lines = []
    with open(file, encoding="utf-8") as text:
        for line in text.read().splitlines()[1:]:
            if not line.startswith("#"):
                break
            lines.append(line[2:])
    return "\n".join(lines)


def printable(text):
    """Names of others with their hidden characters made visible, as printable() of core/util does."""
    return "".join(c if c.isprintable() else f"\\x{ord(c) - 0xdc00:02x}" if 0xdc80 <= ord(c) <= 0xdcff else f"\\u{ord(c):04x}"
                   for c in text)


def die(verb, code, text):
    try:
        print(f"{verb}: {printable(str(text))}", file=sys.stderr)
    except OSError:
        pass
    sys.exit(code)


def run(verb, main):
    """Calls main(words) and exits with what it returns. Output that cannot be written is exit code 1 and a line on stderr; a
    broken pipe ends the verb with 141, as a signal would."""
    for fd, name in ((1, "stdout"), (2, "stderr")):
        if getattr(sys, name) is None:  # closed: one that cannot be written either, so that print fails instead of doing nothing
            unusable = os.open(os.devnull, os.O_RDONLY)
            if unusable != fd:
                os.dup2(unusable, fd)
            setattr(sys, name, os.fdopen(fd, "w", buffering=1 if fd == 2 else -1))
        getattr(sys, name).reconfigure(errors="backslashreplace")
    code = 1
    try:
        try:
            code = main(sys.argv[1:]) or 0
        except SystemExit as end:
            code = end.code or 0
        sys.stdout.flush()
    except KeyboardInterrupt:
        code = 130
    except BrokenPipeError:
        code = 141
    except OSError as fault:
        code = 1
        try:
            print(f"{verb}: {f'{printable(fault.filename)}: ' if fault.filename else 'cannot write to standard output: '}{fault.strerror}",
                  file=sys.stderr)
        except OSError:
            pass
    os._exit(code)  # the interpreter would try once more to write what it still has
