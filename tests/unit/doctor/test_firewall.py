"""What the rules of a firewall do to a bus: those about other traffic are none of its business."""

import pytest

from lcmtools.doctor.firewall import Traffic, refusing_chain

_TRAFFIC = Traffic("239.255.76.67", 7667, "eth0")
_NFT = """table inet filter {
	chain input {
		type filter hook input priority filter; policy %s;
		jump wanted
	}
	chain forward {
		type filter hook forward priority filter; policy drop;
	}
	chain wanted {
		%s
	}
	chain unused {
		drop
	}
}"""
_IPTABLES = """*filter
:INPUT %s [0:0]
:FORWARD DROP [0:0]
:OUTPUT ACCEPT [0:0]
:DOCKER - [0:0]
-A FORWARD -j DOCKER
-A OUTPUT -p udp %s
-A DOCKER -j DROP
COMMIT"""


@pytest.mark.parametrize(
    ("rules", "chain"),
    [
        ("", ""),
        (_NFT % ("accept", "udp dport 53 accept"), ""),
        (_NFT % ("drop", "udp dport 53 accept"), "inet filter input"),
        (_NFT % ("accept", "ip protocol udp drop"), "inet filter input"),
        (_NFT % ("accept", "reject with icmpx admin-prohibited"), "inet filter input"),
        (_IPTABLES % ("ACCEPT", "-j ACCEPT"), ""),
        (_IPTABLES % ("DROP", "-j ACCEPT"), "INPUT"),
        (_IPTABLES % ("ACCEPT", "-j REJECT --reject-with icmp-port-unreachable"), "OUTPUT"),
        (_IPTABLES % ("ACCEPT", "-j DOCKER"), "OUTPUT"),
    ],
)
def test_the_chain_of_a_firewall_that_refuses_is_read(rules, chain):
    assert refusing_chain(rules, _TRAFFIC) == chain


@pytest.mark.parametrize(
    ("policy", "rules", "refuses"),
    [
        ("accept", "tcp dport 25 drop", False),
        ("accept", "udp dport 7667 drop", True),
        ("accept", "udp dport { 1-1024, 5353 } drop", False),
        ("accept", "udp dport 7000-8000 drop", True),
        ("accept", "udp dport != 7667 drop", False),
        ("accept", "ip daddr 239.0.0.0/8 drop", True),
        ("accept", "ip daddr 224.0.0.251 drop", False),
        ("accept", 'iifname "wlan0" drop', False),
        ("accept", 'iifname "eth0" udp dport 7667 counter packets 0 bytes 0 drop', True),
        ("accept", "meta l4proto { tcp, udp } drop", True),
        ("accept", "ct state invalid drop", False),
        ("drop", "ct state established,related accept", True),
        ("drop", "udp dport 7667 accept", False),
        ("drop", "ip saddr 10.0.0.0/8 accept", True),
        ("accept", "meta pkttype multicast drop", True),
        ("accept", "meta pkttype broadcast drop", False),
        ("accept", "ip6 daddr ff02::1 drop", False),
        ("accept", "meta nfproto ipv6 drop", False),
        ("drop", "iif lo accept", True),
        ("accept", "ip protocol icmp drop", False),
        ("accept", "ct state vmap { invalid : drop, established : accept }", False),
        ("accept", "limit rate 5/second drop", False),
        ("accept", "reject with icmpx admin-prohibited", True),
        ("accept", "ip saddr 1.2.3.4 drop", False),
        ("accept", "th dport 7667 drop", True),
        ("accept", "ip daddr { 224.0.0.0/4, 255.255.255.255 } drop", True),
        ("accept", 'log prefix "drop all " drop', True),
        ("drop", "ct state { established, related } accept\n udp dport { 53, 7667 } accept", False),
        ("accept", "ip daddr 224.0.0.0-239.255.255.255 drop", True),
    ],
)
def test_a_rule_of_nft_concerns_the_bus_or_not(policy, rules, *, refuses):
    hook = f"type filter hook input priority 0; policy {policy};"
    chain = f"table inet f {{\n chain c {{\n {hook}\n {rules}\n }}\n}}"
    assert bool(refusing_chain(chain, _TRAFFIC)) == refuses
    assert not refusing_chain(chain.replace("inet", "ip6"), _TRAFFIC)


@pytest.mark.parametrize(
    ("policy", "rules", "refuses"),
    [
        ("ACCEPT", "-A INPUT -p tcp --dport 25 -j DROP", False),
        ("ACCEPT", "-A INPUT -p tcp -m tcp --dport 7667 -j DROP", False),
        ("ACCEPT", "-A INPUT -p udp -m udp --dport 7667 -j DROP", True),
        ("ACCEPT", "-A INPUT -p udp -m multiport --dports 53,7660:7670 -j DROP", True),
        ("ACCEPT", "-A INPUT -p udp -m multiport --dports 53,67 -j DROP", False),
        ("ACCEPT", "-A INPUT ! -p tcp -j DROP", True),
        ("ACCEPT", "-A INPUT -d 224.0.0.0/4 -j REJECT --reject-with icmp-port-unreachable", True),
        ("ACCEPT", "-A INPUT -d 192.168.0.0/16 -j DROP", False),
        ("ACCEPT", "-A INPUT ! -d 224.0.0.0/4 -j DROP", False),
        ("ACCEPT", "-A INPUT -i wlan0 -j DROP", False),
        ("ACCEPT", "-A INPUT ! -i lo -j DROP", True),
        ("ACCEPT", "-A INPUT -i eth+ -j DROP", True),
        ("ACCEPT", "-A INPUT -m conntrack --ctstate INVALID -j DROP", False),
        ("DROP", "-A INPUT -m conntrack --ctstate RELATED,ESTABLISHED -j ACCEPT", True),
        ("DROP", "-A INPUT -p udp --dport 7667 -j ACCEPT", False),
        ("ACCEPT", "-A INPUT -s 10.0.0.5/32 -j DROP", False),
        ("ACCEPT", "-A INPUT -m pkttype --pkt-type multicast -j DROP", True),
        ("ACCEPT", ":f2b - [0:0]\n-A INPUT -p tcp -j f2b\n-A f2b -j DROP", False),
        ("ACCEPT", ":u - [0:0]\n-A INPUT -j u\n-A u -p udp -j DROP", True),
        ("ACCEPT", ":u - [0:0]\n-A INPUT -j u\n-A u -d 224.0.0.0/4 -j RETURN\n-A u -j DROP", False),
    ],
)
def test_a_rule_of_iptables_concerns_the_bus_or_not(policy, rules, *, refuses):
    text = f"*filter\n:INPUT {policy} [0:0]\n:OUTPUT ACCEPT [0:0]\n{rules}\nCOMMIT"
    assert bool(refusing_chain(text, _TRAFFIC)) == refuses
