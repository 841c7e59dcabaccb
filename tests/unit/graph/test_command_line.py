"""The names of programs, from command lines as the system shows them."""

import pytest

from lcmtools.graph.command_line import interpreter, short_name, shortened

JAVA = "/usr/lib/jvm/java-17/bin/java"
SCRIPTS = [  # command line, name and arguments, interpreter
    # programs
    ("lcm-sink -v", "lcm-sink -v", ""),
    ("/usr/bin/lcm-source -m EXAMPLE", "lcm-source -m EXAMPLE", ""),
    ("./build/driver", "driver", ""),
    ("lcmtools echo /gps", "lcmtools echo /gps", ""),
    ("shutdown_watch --fast", "shutdown_watch --fast", ""),
    ("node_exporter --web", "node_exporter --web", ""),
    ("pythonic x", "pythonic x", ""),
    ("/usr/bin/", "/usr/bin/", ""),
    # Python
    ("python drive.py", "drive.py", "python"),
    ("/usr/bin/python3 -u /home/me/drive.py --fast", "drive.py --fast", "python3"),
    ("python3.11 -X dev -W ignore /a/drive.py /gps", "drive.py /gps", "python3.11"),
    ("/opt/v/bin/python3.11 /opt/v/bin/lcmtools run sim", "lcmtools run sim", "python3.11"),
    ("python -m my.driver --fast", "my.driver --fast", "python"),
    ("python3 -m lcmtools echo /gps", "lcmtools echo /gps", "python3"),
    ("pypy3.10 drive.py", "drive.py", "pypy3.10"),
    ("python3 -- drive.py", "drive.py", "python3"),
    ("python3 -", "python3 -", "python3"),
    ("/usr/bin/python3", "python3", "python3"),
    ("python -u -c import sys;exec(eval())", "python -u -c import sys;exec(eval())", "python"),
    ("python -uc 'a\n  b'", "python -uc 'a b'", "python"),
    ("python drive.py -c fast", "drive.py -c fast", "python"),
    ("python drive.py node x.js", "drive.py node x.js", "python"),
    # Java
    (f"{JAVA} -Dx=y -cp /opt/lcm.jar:. my.Driver fast", "my.Driver fast", "java"),
    (f"{JAVA} -Xmx1g -jar /opt/driver.jar -v", "driver.jar -v", "java"),
    (f"{JAVA} -p mods --class-path a.jar -m robot/my.Driver", "my.Driver", "java"),
    # others
    ("node --require ./a.js /srv/drive.js 1", "drive.js 1", "node"),
    ("nodejs drive.js", "drive.js", "nodejs"),
    ("node -e code()", "node -e code()", "node"),
    ("/usr/bin/ruby3.1 -I lib /srv/drive.rb", "drive.rb", "ruby3.1"),
    ("perl -w drive.pl -e", "drive.pl -e", "perl"),
    ("perl -ne print x", "perl -ne print x", "perl"),
    ("lua5.4 drive.lua", "drive.lua", "lua5.4"),
    ("mono --debug Drive.exe", "Drive.exe", "mono"),
    ("/bin/bash /home/me/start.sh robot", "start.sh robot", "bash"),
    ("sh -c ./driver --fast", "sh -c ./driver --fast", "sh"),
    ("bash -lc ./driver", "bash -lc ./driver", "bash"),
    ("bash -o pipefail start.sh", "start.sh", "bash"),
    # what starts others
    ("env LCM_DEFAULT_URL=udpm://239.255.76.67:7667?ttl=0 ./driver -v", "driver -v", ""),
    ("/usr/bin/env -u HOME A=1 B=2 python3 -u drive.py x", "drive.py x", "python3"),
    ("A=1 python3 drive.py", "drive.py", "python3"),
    ("env", "env", ""),
    ("uv run drive.py --fast", "drive.py --fast", ""),
    ("/home/me/.local/bin/uv --quiet run --with lcm -p 3.11 python drive.py", "drive.py", "python"),
    ("uv run -m my.driver", "my.driver", ""),
    ("uv pip list", "uv pip list", ""),
    ("env A=1 uv run python -m my.driver x", "my.driver x", "python"),
    ("", "", ""),
    (" ", "", ""),
]


@pytest.mark.parametrize(("command", "called", "by"), SCRIPTS)
def test_what_only_starts_a_program_is_seen_through(command, called, by):
    assert shortened(command, 1000) == called
    assert short_name(command) == (called.split() or ["?"])[0]
    assert interpreter(command) == by


@pytest.mark.parametrize(
    ("command", "called"),
    [
        ("/opt/a/very/long/way/to/bin/lcm-sink -v", "lcm-sink -v"),
        ("/usr/bin/python3 -u /home/ada/drive.py /gps", "drive.py /gps"),
        ("sender --speed 0.3 0123456", "sender --speed 0.3 …"),
        ("sender --channels /gps /imu --speed 0.3", "sender --channels /gps …"),
        ("/usr/bin/ some-words-that-are-more-than-there-is-room", "/usr/bin/ …"),
        ("/bin/a-name-that-is-more-than-there-is-room", "a-name-that-is-more-tha …"),
    ],
)
def test_words_at_the_end_are_left_out_for_want_of_room(command, called):
    assert shortened(command, 25) == called
    assert len(called) <= 25
