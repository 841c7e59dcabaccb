"""The talker and the listener."""

from lcmtools.labs.nodes.listener import Listener
from lcmtools.labs.nodes.talker import Talker
from lcmtools.types.std_msgs import String


def test_talker_counts_from_zero_ten_times_a_second(bench):
    bench.start(Talker, "_use_sim_time:=true")
    bench.advance_time(0.05, 0.1, 0.15, 0.2, 0.3)
    texts = [message.data for message in bench.published("/chatter", String)]
    assert texts == ["hello world 0", "hello world 1", "hello world 2"]


def test_talker_logs_what_it_says(bench, capsys):
    bench.start(Talker, "_use_sim_time:=true")
    bench.advance_time(0.1)
    assert capsys.readouterr().err == "[INFO] [0.100000000] [/talker]: hello world 0\n"


def test_talker_talks_in_its_namespace_on_the_remapped_topic(bench):
    bench.start(Talker, "_use_sim_time:=true", "__ns:=/lab", "chatter:=news")
    bench.advance_time(0.1)
    assert [message.data for message in bench.published("/lab/news", String)] == ["hello world 0"]


def test_listener_logs_what_it_hears(bench, capsys):
    bench.start(Listener)
    message = String()
    message.data = "hello world 7"
    bench.publish("/chatter", message)
    assert capsys.readouterr().err.endswith("[/listener]: I heard: [hello world 7]\n")
