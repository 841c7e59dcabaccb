import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;

/** Listens: Listens CHANNEL. */
public class Listens implements LCMSubscriber {
    public static void main(String[] words) throws Exception {
        LCM bus = new LCM();
        bus.subscribe(words[0], new Listens());
        System.out.println("ready");
        Thread.sleep(1000000);
    }

    public void messageReceived(LCM bus, String channel, LCMDataInputStream stream) {
        // it only listens
    }
}
