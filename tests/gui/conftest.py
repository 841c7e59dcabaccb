"""Fixtures of the tests of the window: a real Chromium, and a server with pages in it."""

import json
import shutil
from urllib.parse import quote, urlsplit

import pytest

_ARGUMENTS = (
    "--no-sandbox",
    "--use-angle=swiftshader",  # WebGL without a graphics card
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)


@pytest.fixture(scope="module")
def browser_data(tmp_path_factory):
    """The folder of the browser's data, which is in the command line of all its processes."""
    return tmp_path_factory.mktemp("browser")


@pytest.fixture(scope="module")
def launch_browser():
    """``launch_browser(folder)``: a Chromium with its data in a folder, as playwright has it."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        pytest.skip("tests of the window need Chromium")
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as started:

        def launch(folder, **options):
            return started.chromium.launch_persistent_context(
                folder, executable_path=chromium, args=[*_ARGUMENTS], **options
            )

        yield launch


@pytest.fixture(scope="module")
def browser(launch_browser, browser_data):
    """A browser that the tests of a module share."""
    context = launch_browser(browser_data)
    context.set_default_timeout(40_000)
    yield context
    context.close()


@pytest.fixture
def serve(module_start, lcmtools_path):
    """``serve("steer", "/v")``: the window's process on the module's bus, and its address."""

    def run(*words):
        panel = words or ("all",)
        server = module_start(lcmtools_path, "gui", *panel, "--port", "0", "--no-open")
        return server, server.wait_for("http://").split()[-1]

    return run


@pytest.fixture
def page(browser):
    """A page; what goes wrong in it, and a request to another computer, fails the test."""
    opened = browser.new_page()
    errors = []

    def take_line(line):
        if line.type == "error" and "WebSocket connection" not in line.text:  # the server has ended
            errors.append(line.text)

    def take_request(request):
        if not request.url.startswith(("http://127.0.0.1:", "ws://127.0.0.1:", "blob:", "data:")):
            errors.append(f"a request to {request.url}")

    opened.on("pageerror", lambda error: errors.append(str(error)))
    opened.on("console", take_line)
    opened.on("request", take_request)
    yield opened
    opened.close()
    assert errors == []


def panel_address(address, panel, **settings):
    """Return the address of one panel."""
    return f"{address}#{quote(json.dumps({'panel': panel, 'settings': settings}))}"


def press_rare(page, name):
    """Press a tool in the menu of the rarely used ones, and leave the menu open."""
    open_more(page)
    page.get_by_role("button", name=name, exact=True).click()


def open_more(page):
    """Open the menu of the rarely used tools, unless it is open."""
    if not page.locator(".more:popover-open").count():
        page.get_by_role("button", name="More …").click()


def forget_layouts(page, address):
    """Remove what the browser has stored for a server's pages."""
    client = page.context.new_cdp_session(page)
    origin = "{0.scheme}://{0.netloc}".format(urlsplit(address))
    about = {"origin": origin, "storageTypes": "local_storage"}
    client.send("Storage.clearDataForOrigin", about)
    client.detach()
