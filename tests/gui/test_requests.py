"""Services, parameters and recordings in a real browser, with a node as the witness."""

import signal

import pytest

import lcmtools
from lcmtools import Node
from lcmtools.types.std_srvs import SetBool
from tests.gui.conftest import panel_address


class Server(Node):
    """A node with a service and a parameter."""

    def __init__(self):
        super().__init__("server")
        self.received = []
        self.create_service(SetBool, "switch", self._switch)
        self.declare_parameter("gain", 1.0, "of the effort", minimum=0.0, maximum=10.0)

    def _switch(self, request, response):
        self.received.append(request.data)
        if not request.data:
            raise RuntimeError("no power")
        response.success, response.message = True, "switched"
        return response


@pytest.fixture(scope="module")
def node(module_start_node):
    """A node on the module's bus."""
    return module_start_node(Server).node


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    """Where the window records."""
    return tmp_path_factory.mktemp("recordings")


@pytest.fixture(scope="module")
def address(module_start, lcmtools_path, directory):
    """The address of a window that the tests share."""
    words = ("gui", "--port", "0", "--no-open", "--record-directory", str(directory))
    server = module_start(lcmtools_path, *words)
    return server.wait_for("http://").split()[-1]


def test_a_service_is_chosen_called_and_its_answer_unfolded(page, address, node):
    page.goto(panel_address(address, "services"))
    page.get_by_label("Service", exact=True).select_option("/switch")
    page.get_by_text("std_srvs/SetBool of /server").wait_for()
    form = page.get_by_role("form", name="Call")
    form.get_by_role("checkbox").check()
    form.get_by_role("button", name="Call").click()
    page.get_by_text("answered after").wait_for()
    tree = page.get_by_role("tree", name="Answer")
    assert '"switched"' in tree.locator("[data-path=message]").inner_text()
    assert node.received == [True]
    node.received.clear()
    form.get_by_role("checkbox").uncheck()
    form.get_by_role("button", name="Call").press("Enter")
    form.get_by_text("no power").wait_for()
    assert tree.count() == 0
    form.get_by_role("checkbox").check()
    form.get_by_role("button", name="Call").click()
    tree.wait_for()
    page.get_by_label("Service", exact=True).select_option("")
    page.get_by_text("Choose a service.").wait_for()
    assert tree.count() == 0  # of the service before
    page.get_by_label("Service", exact=True).select_option("/switch")
    page.reload()
    page.get_by_text("std_srvs/SetBool of /server").wait_for()  # it is chosen again


@pytest.mark.usefixtures("node")
def test_a_parameter_is_set_or_refused_by_its_node(page, address, node, wait_until):
    page.goto(panel_address(address, "parameters"))
    page.get_by_label("Node", exact=True).select_option("/server")
    gain = page.get_by_label("gain")
    gain.fill("2.5")
    gain.press("Enter")
    page.get_by_text("/server/gain is now 2.5").wait_for()
    assert node.get_parameter("gain").value == 2.5
    gain.fill("99")
    gain.press("Enter")
    page.locator(".result.is-bad", has_text="gain").wait_for()
    assert gain.input_value() == "2.5"
    page.get_by_label("use_sim_time").focus()
    node.set_parameters([lcmtools.Parameter("gain", value=4.0)])
    wait_until(lambda: gain.input_value() == "4.0")  # another program's change is shown


def test_a_recording_is_started_and_stopped(page, address, directory, module_start, lcmtools_path):
    module_start(lcmtools_path, "run", "talker").wait_for("hello")
    page.goto(panel_address(address, "record"))
    page.get_by_label("/chatter", exact=True).check()
    page.get_by_text("/chatter", exact=True).nth(1).wait_for()
    page.get_by_role("button", name="Record").click()
    page.get_by_text("recording for 1 s: ").wait_for()
    assert page.get_by_role("checkbox").count() == 0  # the topics of a running recording stay
    page.get_by_role("button", name="Stop").click()
    page.get_by_text("; no losses").wait_for()
    page.get_by_role("button", name="Record").wait_for()
    [path] = directory.glob("*.lcmlog")
    with lcmtools.bag.open(path) as log:
        assert list(log.topics) == ["/chatter"]


@pytest.mark.usefixtures("node")
@pytest.mark.parametrize(
    ("panel", "control"), [("services", "Call"), ("record", "Record"), ("parameters", "gain")]
)
def test_a_page_that_may_only_watch_has_no_controls(serve, page, panel, control):
    _, address = serve("all", "--read-only")
    page.goto(panel_address(address, panel, node="/server"))
    page.get_by_text("this page may only watch, not command").wait_for()
    role = "textbox" if panel == "parameters" else "button"
    assert page.get_by_role(role, name=control).is_disabled()


def test_values_of_a_node_that_does_not_answer_are_marked_as_old(
    page, address, start, lcmtools_path, module_bus_url
):
    talker = start(lcmtools_path, "run", "talker", "__node:=mute", LCM_DEFAULT_URL=module_bus_url)
    talker.wait_for("hello")
    page.goto(panel_address(address, "parameters", node="/mute"))
    page.get_by_label("use_sim_time").wait_for()
    fields = page.get_by_role("group", name="Parameters")
    assert "muted" not in fields.get_attribute("class")
    talker.send_signal(signal.SIGSTOP)
    page.get_by_text("/mute did not answer within 3 s").wait_for()
    page.locator("fieldset.muted").wait_for()
    talker.send_signal(signal.SIGCONT)
    page.locator("fieldset.muted").wait_for(state="detached")
